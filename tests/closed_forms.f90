!> Tests. The closed form of each deck in input/, chosen by the deck's base name, and what the listing says of its
!> structure, counted by hand.
module closed_forms
   use structure, only: findings_t
   use quad_jet, only: qp
   use closed_forms_dyads, only: body_t
   use closed_forms_linkages, only: four_bar, drag_link, peaucellier, five_bar, pantograph
   use closed_forms_sliders, only: yoke, crank_slider, scotch_yoke, whitworth, cylinder, trammel
   use closed_forms_legs, only: andrews, jansen
   implicit none
   private
   public :: closed_form, hand_count

   !> Counts of a mechanism made by eye from the drawing in its deck.
   type :: count_t
      character(13) :: deck
      integer :: links, revolute, prismatic, drives   !< links with the ground
   end type count_t

   type(count_t), parameter :: counts(14) = [ &
      count_t('yoke', 6, 5, 2, 1), count_t('yoke_mirrored', 6, 5, 2, 1), count_t('four_bar', 4, 4, 0, 1), &
      count_t('crank_slider', 4, 3, 1, 1), count_t('scotch_yoke', 4, 2, 2, 1), count_t('whitworth', 6, 5, 2, 1), &
      count_t('drag_link', 4, 4, 0, 1), count_t('cylinder', 4, 3, 1, 1), count_t('trammel', 4, 2, 2, 1), &
      count_t('peaucellier', 8, 10, 0, 1), count_t('five_bar', 5, 5, 0, 2), count_t('pantograph', 5, 5, 0, 2), &
      count_t('andrews', 8, 10, 0, 1), count_t('jansen', 8, 10, 0, 1)]

contains

   !> The links of the mechanism `name` at the time `t`, in its set number `set`; none for an unknown name.
   !> The angles are on any branch: whoever asks brings them to the branch wanted.
   pure function closed_form(name, set, t) result(links)
      character(*), intent(in) :: name
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t), allocatable :: links(:)

      select case (name)
      case ('yoke')
         links = yoke(set, t, 1.0_qp)
      case ('yoke_mirrored')
         links = yoke(set, t, -1.0_qp)
      case ('four_bar')
         links = four_bar(set, t)
      case ('crank_slider')
         links = crank_slider(set, t)
      case ('scotch_yoke')
         links = scotch_yoke(set, t)
      case ('whitworth')
         links = whitworth(t)
      case ('drag_link')
         links = drag_link(set, t)
      case ('cylinder')
         links = cylinder(t)
      case ('trammel')
         links = trammel(set, t)
      case ('peaucellier')
         links = peaucellier(t)
      case ('five_bar')
         links = five_bar(t)
      case ('pantograph')
         links = pantograph(set, t)
      case ('andrews')
         links = andrews(set, t)
      case ('jansen')
         links = jansen(t)
      case default
         allocate (links(0))
      end select
   end function closed_form

   !> What the listing must say of the structure of the mechanism `name`: one ground link, every link with three
   !> coordinates, two equations for every pair and three for the ground.
   pure function hand_count(name) result(f)
      character(*), intent(in) :: name
      type(findings_t) :: f
      integer :: i

      do i = 1, size(counts)
         if (counts(i)%deck /= name) cycle
         f%links = counts(i)%links
         f%ground = 1
         f%revolute = counts(i)%revolute
         f%prismatic = counts(i)%prismatic
         f%drives = counts(i)%drives
         f%coordinates = 3*f%links
         f%equations = 2*(f%revolute + f%prismatic) + 3
         ! In every one of these mechanisms the freedoms are driven one by one.
         f%freedoms = f%drives
      end do
   end function hand_count
end module closed_forms
