!> The blocks of a mechanism in solving order, as data made for fast evaluation: for each block the vector loops it
!> closes, split into the part that earlier blocks have found and the part it solves for. The numbers of the cards make
!> `geometry_t` of them: a variant has equal blocks with other numbers (`block_numbers`).
!>
!> Unknowns: 1 to `orientations` are the angles of the orientations; then come the slides; then x and y of each root
!> (a part that no pair joins to the ground). A block is one drive only, or the part that the tree leaves of one or
!> more Assur groups with their drives. Contract: a block needs unknowns of earlier blocks only; every unknown belongs
!> to exactly one block.
!>
!> Blocks that are solved: those whose unknowns move a link that a table names, and the blocks on which these build.
!> Of these blocks, only those that a drive moves are solved at every step.
module blocks
   use kinds, only: wp
   use number_types, only: vector_t, row_numbers_t, loop_numbers_t, link_numbers_t
   use cylinders, only: cylinder_t
   use klu, only: pattern_t
   use block_matrix, only: matrix_layout_t
   use spanning_tree, only: spanning_tree_t
   use loop_equations, only: equations_t, equation_numbers_t
   implicit none
   private
   public :: blocks_t, block_t, equation_row_t, block_loop_t, body_vector_t, slide_t, loop_components, &
      loop_projection, loop_angles, geometry_t, link_order_t, link_step_t, block_numbers_t, row_numbers_t, &
      loop_numbers_t
   public :: blocks_that_give, blocks_below, largest_known, known_to, own_unknowns

   integer, parameter :: loop_components = 1  !< x and y of a vector loop, or one of them
   integer, parameter :: loop_projection = 2  !< the projection of a vector loop
   integer, parameter :: loop_angles = 3      !< no vector loop: an angle, an angle less another, or a slide

   !> Unknowns, rows of equations and loops of a block. It has as many rows as unknowns; only the first block can have
   !> more rows, if equations are too many.
   type :: block_t
      integer :: first = 1, last = 0              !< its unknowns: unknown(first:last) of `blocks_t`
      integer :: first_row = 1, last_row = 0      !< its rows: rows(first_row:last_row) of `blocks_t`
      integer :: first_loop = 1, last_loop = 0    !< its loops: loops(first_loop:last_loop); of an explicit block none
      type(matrix_layout_t) :: shape              !< of its Jacobian
      integer :: cleared = 0                      !< entries of its Jacobian to clear: 0 if body vectors set all
      logical :: explicit = .false.               !< one equation with one unknown, of coefficient 1 or -1
   end type block_t

   !> The right-hand side of an equation: constant + value of the drive. An explicit block has the unknown
   !> `other` + sign_of (constant + value).
   type :: equation_row_t
      integer :: drive = 0                        !< the number of the drive whose value is added; 0: none
      integer :: other = 0                        !< explicit: the unknown that is added; 0: the ground's angle, or none
      integer :: pair = 0                         !< the number of the pair that has this equation; 0: a drive has it
      logical :: angular = .false.                !< in radians, not lengths
      integer :: sign_of = 1                      !< explicit: 1 or -1
   end type equation_row_t

   !> A vector loop as one block has it. Body vectors that angles of earlier blocks rotate come first, then those that
   !> the block's own angles rotate. Numbers of rows and columns count from 1 in the block; 0: none.
   type :: block_loop_t
      integer :: kind = loop_components           !< which equations its rows are: loop_components, ...
      integer :: row_x = 0, row_y = 0             !< rows of x and y; the one row of a projection or of angles is row_x
      !> Its body vectors; from first_own on those that angles of the block rotate.
      integer :: first_vector = 1, first_own = 1, last_vector = 0
      integer :: first_slide = 1, last_slide = 0  !< its slides
      !> The unknown with which the projection turns, or the first unknown of `loop_angles`; 0: the ground's angle.
      integer :: orientation = 0, orientation_column = 0
      integer :: less = 0, less_column = 0        !< loop_angles: the angle that is subtracted; 0: the ground's, or none
      integer :: vector_loop = 0                  !< the number of the vector loop of which it was made; 0: none
      integer :: orientation_at = 0, less_at = 0        !< the addresses of their entries in the Jacobian; 0: none
   end type block_loop_t

   !> A body vector of a loop.
   type :: body_vector_t
      !> The angle that rotates it; the column of this angle in the block (0: an earlier block has it); the addresses of
      !> its entries in the rows row_x and row_y of the Jacobian (0: none).
      integer :: orientation = 0, column = 0, at(2) = 0
      integer :: source = 0                       !< its number in the vector loops
   end type body_vector_t

   !> A slide of a loop.
   type :: slide_t
      !> The angle that rotates its guide, and the unknown that is its length, each with its column in the block (0: an
      !> earlier block has it); the addresses of the entries of the length and of the angle in the rows row_x and row_y
      !> of the Jacobian (0: none).
      integer :: orientation = 0, orientation_column = 0, unknown = 0, column = 0, at(2) = 0, orientation_at(2) = 0
      integer :: source = 0                       !< its number in the vector loops
   end type slide_t

   !> The numbers that the cards make of a block.
   type :: block_numbers_t
      logical :: has_right_sides = .true.         !< some equation has a drive, or a constant that is not 0
      real(wp) :: coarse = 1.0_wp                 !< the largest `coarse` of its loops, 1 at least
      real(wp) :: lipschitz = 0.0_wp              !< bounds |change of its Jacobian|/|change of its unknowns|
   end type block_numbers_t

   !> A moving link. Numbers are 0 for the ground, for no pair, no slide and no root.
   type :: link_step_t
      integer :: link = 0, parent = 0                   !< its number and that of its parent
      integer :: orientation = 0, parent_orientation = 0 !< the unknowns that rotate link and parent
      integer :: slide = 0                              !< its unknown
      integer :: root = 0                               !< the unknown that is its x; y is the next
      logical :: has_body_vector = .false.              !< its origin is not the point that joins it to the parent
      type(link_numbers_t) :: numbers                   !< of its position on the parent
   end type link_step_t

   !> The moving links, the wanted ones first, parents before their children; and the ground links.
   type :: link_order_t
      type(link_step_t), allocatable :: links(:)        !< (moving links)
      integer, allocatable :: ground(:)                 !< numbers of the ground links
      integer :: wanted = 0                             !< so many of `links` are wanted, or parents of wanted ones
      real(wp), allocatable :: ground_position(:, :)    !< (3, ground links) x, y from `origin` (deck's unit), phi (rad)
      real(wp) :: origin(2) = 0.0_wp                    !< from which positions are counted, in the deck's unit
   end type link_order_t

   !> The numbers that the cards make of the blocks.
   type :: geometry_t
      real(wp) :: tolerance = 0.0_wp              !< relative, of corrections; 0: the limit of rounding
      real(wp) :: span = 1.0_wp                   !< the characteristic length, in the deck's unit
      real(wp) :: closing = 0.0_wp                !< closing tolerance of redundant equations (unit of the loop, rad)
      type(equation_numbers_t) :: equations       !< their unit of length: the largest power of two not above `span`
      type(block_numbers_t), allocatable :: blocks(:)   !< (blocks)
      type(row_numbers_t), allocatable :: rows(:)       !< (rows)
      type(loop_numbers_t), allocatable :: loops(:)     !< (loops)
      type(vector_t), allocatable :: d(:)         !< (body vectors) in the axes of the orientation, unit of the loop
      !> (slides) Along the guide, with its sign in the loop: times the unknown it is the slide in the unit of the loop.
      type(vector_t), allocatable :: e(:)
      real(wp), allocatable :: unit(:)            !< (0:unknowns) of a slide or root, in that of `equations`; 1: angles
      type(link_order_t) :: chain                 !< the links in the order in which they are moved
      type(cylinder_t), allocatable :: cylinders(:)   !< all cylinders of the mechanism
   end type geometry_t

   !> The structure of a mechanism in blocks.
   type :: blocks_t
      integer :: orientations = 0, unknowns = 0   !< angles; angles, slides and coordinates of roots together
      logical :: solvable = .false.               !< each unknown has an equation of its own
      integer :: redundant = 0                    !< equations that found no unknown
      integer :: free = 0                         !< unknowns that found no equation
      integer, allocatable :: loose(:)            !< if `free` > 0: all unknowns that another matching could leave free
      type(block_t), allocatable :: list(:)       !< in solving order
      integer, allocatable :: unknown(:)          !< (unknowns) their numbers, block by block
      integer, allocatable :: block_of(:)         !< (unknowns) the number of the block that solves for it
      type(equation_row_t), allocatable :: rows(:)      !< (rows) block by block
      integer, allocatable :: equation(:)         !< (rows) its number among the equations
      type(block_loop_t), allocatable :: loops(:)       !< (loops) block by block
      type(body_vector_t), allocatable :: body_vectors(:)   !< (body vectors) loop by loop
      type(slide_t), allocatable :: slides(:)           !< (slides) loop by loop
      type(pattern_t), allocatable :: patterns(:) !< of the blocks with a sparse Jacobian
      type(spanning_tree_t) :: tree               !< of the mechanism
      ! For the requests:
      !> Numbers of the blocks that are solved, in solving order; those of them that drives move: solved at every step.
      integer, allocatable :: needed(:), moving(:)
      integer, allocatable :: ratios(:)                 !< numbers of the drives by which ratios are requested
      integer, allocatable :: joint(:, :)               !< (2, revolute pairs) the numbers of the links of each
      logical, allocatable :: is_found(:)               !< (links) a table needs it, and its angle takes iterations
      type(equations_t) :: equations              !< of which the blocks were made
   end type blocks_t

contains

   !> Lists the unknowns of a block, in the order of its columns.
   pure function own_unknowns(b, i) result(list)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i   !< the number of the block
      integer :: list(b%list(i)%last - b%list(i)%first + 1)   !< their numbers

      list = b%unknown(b%list(i)%first:b%list(i)%last)
   end function own_unknowns

   !> Lists a block and all blocks on which it builds, in solving order.
   function blocks_below(b, i) result(list)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i   !< the number of the block
      integer, allocatable :: list(:)   !< numbers of blocks
      logical :: need(0:b%unknowns)
      integer :: k

      need = .false.
      list = blocks_that_give(b, [(k == i, k=1, size(b%list))], need)
   end function blocks_below

   !> Lists the blocks that are wanted, those that solve for wanted unknowns, and all on which they build, in solving
   !> order.
   function blocks_that_give(b, taken, need) result(list)
      type(blocks_t), intent(in) :: b
      logical, intent(in) :: taken(:)        !< (blocks) the block is wanted
      logical, intent(inout) :: need(0:)     !< (0:unknowns) the unknown is wanted; then also if a listed block needs it
      integer, allocatable :: list(:)        !< numbers of blocks
      logical :: needed(size(taken))
      integer :: i

      do i = size(taken), 1, -1
         needed(i) = taken(i) .or. any(need(own_unknowns(b, i)))
         if (needed(i)) need(known_to(b, i)) = .true.
      end do
      list = pack([(i, i=1, size(taken))], needed)
   end function blocks_that_give

   !> Gives the largest of the numbers that mark the unknowns on which a block builds; 0 at least.
   pure integer function largest_known(b, i, mark) result(largest)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i               !< the number of the block
      integer, intent(in) :: mark(0:)        !< (0:unknowns) any numbers; 0 for the block's own unknowns

      largest = maxval([0, mark(known_to(b, i))])
   end function largest_known

   !> Lists the unknowns in the equations of a block, those of other blocks and its own, some more than once. An
   !> explicit block has only the unknown that is added.
   pure function known_to(b, i) result(list)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i   !< the number of the block
      integer, allocatable :: list(:)   !< their numbers; 0: the ground's angle, or none

      associate (block => b%list(i))
         list = b%rows(block%first_row:block%last_row)%other
         if (block%first_loop > block%last_loop) return
         associate (loops => b%loops(block%first_loop:block%last_loop))
            associate (v => loops(1)%first_vector, w => loops(size(loops))%last_vector, &
               s => loops(1)%first_slide, t => loops(size(loops))%last_slide)
               list = [list, loops%orientation, loops%less, b%body_vectors(v:w)%orientation, &
                  b%slides(s:t)%orientation, b%slides(s:t)%unknown]
            end associate
         end associate
      end associate
   end function known_to
end module blocks
